#!/bin/sh
# A spruce grows for 34 years in ten seconds while the camera goes half round it; new shoots grow between the years. Words
# after the name of the film are options of `understory fly`:
#
#     examples/flight/spruce.sh spruce.mp4 --size 480x640 --samples 16
film=${1:?which film? for example spruce.mp4}
shift
exec understory fly "$(dirname "$0")/../spruce.rgg" -o "$film" --grow 0..34 \
	--key 'time=0 eye=2.2,-2.2,0.7 target=0,0,0.4; time=2 eye=5,-6,1.8 target=0,0,1.3; time=5 eye=14,-18,4 target=0,0,4; time=10 eye=-14,-29,5 target=0,0,7.2' "$@"
