#!/bin/sh
# A film by a real Slurm, beside the same film by one run: are they the same, byte for byte? One task is killed in the middle and the
# job submitted again. Needs root, a built program and Debian's packages `slurmctld slurmd munge`; a few minutes. The controller and
# the only node run on this machine, in a temporary folder, and are stopped at the end.
#
#     cargo build --release && benches/slurm.sh [target/release/understory]
set -eu
program=$(realpath "${1:-target/release/understory}")
crop=$(realpath "$(dirname "$0")/../examples/crop.rgg")
folder=$(mktemp -d)
export SLURM_CONF="$folder/slurm.conf"
cat > "$SLURM_CONF" <<CONF
ClusterName=understory
SlurmctldHost=$(hostname)
SlurmUser=root
AuthType=auth/munge
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/controller.pid
SlurmdPidFile=$folder/node.pid
MailProg=/bin/true
ReturnToService=2
NodeName=$(hostname) CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$(hostname) Default=YES MaxTime=INFINITE State=UP
CONF
mkdir "$folder/state" "$folder/spool"
mkdir -p /run/munge && chown munge: /run/munge
pgrep munged > /dev/null || runuser -u munge -- munged --force 2> /dev/null
slurmctld -D > "$folder/controller.log" 2>&1 & controller=$!
sleep 2
slurmd -D > "$folder/node.log" 2>&1 & node=$!
finish() { kill "$node" "$controller" 2> /dev/null || true; wait; rm -rf "$folder"; }
trap finish EXIT
until sinfo -h -o %T | grep -q idle; do sleep 1; done
cd "$folder"

# Waits until no job is left in the queue.
queue_is_empty() { [ -z "$(squeue -h)" ]; }
drained() { until queue_is_empty; do sleep 1; done; }

# Compares the film NAME of a cluster with that of one run, by the same flags; submits again until it is there.
same() {
    name=$1
    shift
    "$program" fly "$@" -o "$name.mp4" --slurm "$name.sh" --quiet
    bash "$name.sh"
    # Kills the first task of the array that has run for a second.
    until task=$(squeue -h -t R -o '%i %M' | awk '$1 ~ /_/ && $2 != "0:00" { print $1; exit }') && [ -n "$task" ]; do
        queue_is_empty && break
        sleep 0.2
    done
    [ -z "$task" ] || { scancel --signal=KILL --full "$task" && echo "killed task $task"; }
    drained
    if [ ! -e "$name.mp4" ]; then
        echo "no film without that task's frames, as it should be; submitting again"
        bash "$name.sh"
        drained
    fi
    if [ -n "${chosen:-}" ]; then
        cat "$name.mp4.frames/chosen.toml" 2> /dev/null || true
    fi
    "$program" fly "$@" -o "$name-one-run.mp4" --quiet
    if cmp "$name.mp4" "$name-one-run.mp4"; then
        echo "$name: the same $(stat -c %s "$name.mp4") bytes"
    else
        echo "$name: DIFFERENT"
        exit 1
    fi
}

cp "$crop" crop.rgg
same solved crop.rgg --renderer photon --global-photons 50000 --orbit --flight-frames 12 --size 96x54 --samples 4 --threads 1
chosen=yes same wished crop.rgg --error 6% --orbit --flight-frames 12 --size 96x54 --threads 1
