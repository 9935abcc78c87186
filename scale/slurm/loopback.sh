#!/usr/bin/env bash
# A Slurm cluster on this machine alone, to try and to measure with: controller, node and munge, as the user who calls.
#
#   scale/slurm/loopback.sh start DIR    # DIR must not be there; then: export SLURM_CONF=DIR/slurm.conf
#   scale/slurm/loopback.sh stop DIR
#
# Debian: apt install slurmctld slurmd slurm-client munge
set -euo pipefail
PATH=$PATH:/usr/sbin:/sbin

fail() {
    echo "loopback.sh: $*" >&2
    exit 2
}

# The configuration, with ports that nobody listens on.
configuration() {
    local folder=$1 host user ports
    host=$(hostname -s) user=$(id -un)
    ports=$(python3 -c 'import socket; s = [socket.create_server(("", 0)) for _ in "12"]; print(*(x.getsockname()[1] for x in s))')
    cat <<EOF
ClusterName=loopback
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports% *}
SlurmdPort=${ports#* }
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
ReturnToService=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
EOF
}

start() {
    local folder
    [[ $(realpath --canonicalize-missing "$1") != *[[:space:]]* ]] || fail "$1: a path with spaces is none for slurm.conf"
    mkdir "$1" 2>/dev/null || fail "$1: is there already, or cannot be made"
    folder=$(realpath "$1")
    mkdir "$folder/state" "$folder/spool"
    (umask 077 && head --bytes=1024 /dev/urandom >"$folder/munge.key")
    configuration "$folder" >"$folder/slurm.conf"
    export SLURM_CONF=$folder/slurm.conf
    # Munge wants to know that nobody else can write its folder; here it is the user's own.
    {
        munged --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munged.pid" \
            --log-file="$folder/munged.log" --seed-file="$folder/munge.seed" 2>/dev/null && slurmctld && slurmd
    } || {
        stop "$folder"
        fail "munged, slurmctld or slurmd did not start; see $folder/*.log"
    }
    for _ in $(seq 150); do
        [[ $(sinfo --noheader --format=%T 2>/dev/null) != idle ]] || return 0
        sleep 0.2
    done
    stop "$folder"
    fail "no node was ready within 30 s; see $folder/*.log"
}

stop() {
    local daemon
    for daemon in slurmd slurmctld munged; do
        [[ ! -f $1/$daemon.pid ]] || kill "$(<"$1/$daemon.pid")" 2>/dev/null || true
    done
}

[[ $# -eq 2 && $1 =~ ^(start|stop)$ ]] || fail "usage: loopback.sh start|stop DIR"
for program in munged slurmctld slurmd sinfo; do
    command -v "$program" >/dev/null || fail "$program is not there; Debian: apt install slurmctld slurmd slurm-client munge"
done
"$1" "$2"
