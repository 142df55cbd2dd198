#!/bin/sh
# The study's Cornell box: an arc before its open side, one light for all frames. Words after the name of the film are options
# of `understory fly`:
#
#     examples/flight/cornell.sh cornell.mp4 --renderer photon --samples 16
film=${1:?which film? for example cornell.mp4}
shift
exec understory fly "$(dirname "$0")/../study/cornell.rgg" -o "$film" \
	--key 'time=0 eye=-0.9,-3.5,1.4 target=0,0,0.95; time=3 eye=0,-3.0,0.8; time=6 eye=0.9,-3.5,1.4; time=9 eye=0,-4.2,1.1; time=12 eye=-0.9,-3.5,1.4' "$@"
