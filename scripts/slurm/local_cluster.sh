# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by scripts/slurm/test.
# shellcheck shell=bash
# A Slurm cluster of one node on this machine's loopback, for tests; to be sourced by bash. It lives in a folder of its
# own, with its own ports, munge key and socket: a Slurm or munge that the machine runs already is neither used nor
# touched, and the user need not be root.
#   start_cluster FOLDER CPUS     returns when jobs can be submitted; SLURM_CONF then leads every Slurm command to it
#   stop_cluster                  cancels what is left, ends the daemons and whatever they started
#   remove_left_behind NAME       ends and removes the clusters in NAME.PID.* of processes that were killed
# The folder is to be empty, and no folder above it closed to others (munge insists on both).

cluster_folder=
cluster_daemons=()

# A port that nobody listens on, out of the range that connections are given theirs from.
free_port() {
  local port
  for port in $(shuf -i 20000-29999 -n 50); do
    (exec 3<> "/dev/tcp/127.0.0.1/$port") 2> /dev/null || { echo "$port"; return; }
  done
  return 1
}

# A requeued job waits until the credential of its last start has expired: two minutes by default, and no less than the
# five seconds of cred_expire.
write_slurm_conf() {
  local cpus=$1 host user
  host=$(hostname -s) user=$(id -un)
  cat << CONF
ClusterName=salbench-test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$cluster_folder/munge.socket,cred_expire=5
StateSaveLocation=$cluster_folder/state
SlurmdSpoolDir=$cluster_folder/spool
SlurmctldPidFile=$cluster_folder/slurmctld.pid
SlurmdPidFile=$cluster_folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/builtin
SchedulerParameters=sched_interval=1
SlurmdParameters=config_overrides
KillWait=5
NodeName=$host NodeAddr=127.0.0.1 CPUs=$cpus State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
}

# start_daemon NAME COMMAND...: in the background, its output in NAME.log.
start_daemon() {
  "${@:2}" > "$cluster_folder/$1.log" 2>&1 &
  cluster_daemons+=($!)
}

# wait_for SECONDS COMMAND...: until the command succeeds; fails where it never did.
wait_for() {
  local until=$((SECONDS + $1))
  until "${@:2}" > /dev/null 2>&1; do
    ((SECONDS < until)) || return 1
    sleep 0.1
  done
}

node_is_idle() { [[ $(sinfo --noheader --format=%T) == idle ]]; }
queue_is_empty() { [[ -z $(squeue --noheader) ]]; }

start_cluster() {
  cluster_folder=$1
  chmod 755 "$cluster_folder"
  mkdir "$cluster_folder/state" "$cluster_folder/spool"
  (umask 077 && head -c 128 /dev/urandom > "$cluster_folder/munge.key")
  export SLURM_CONF=$cluster_folder/slurm.conf
  write_slurm_conf "$2" > "$SLURM_CONF"
  # Slurm of Debian 13 does not start without cgroups unless told so; that of Debian 12 does not know the word.
  [[ $(slurmd -V) == *' 22.'* ]] || echo CgroupPlugin=disabled > "$cluster_folder/cgroup.conf"

  start_daemon munged munged --foreground --key-file="$cluster_folder/munge.key" --socket="$cluster_folder/munge.socket" \
    --pid-file="$cluster_folder/munged.pid" --seed-file="$cluster_folder/munge.seed" \
    --log-file="$cluster_folder/munge.log"
  wait_for 10 test -S "$cluster_folder/munge.socket" || return 1
  start_daemon slurmctld slurmctld -D
  start_daemon slurmd slurmd -D
  wait_for 30 node_is_idle
}

daemons_have_ended() { ! kill -0 "${cluster_daemons[@]}"; }

# Whatever a daemon of a cluster in this folder started carries its SLURM_CONF.
processes_of() { { grep -lzFx "SLURM_CONF=$1/slurm.conf" /proc/[0-9]*/environ 2> /dev/null || true; } | cut -d/ -f3; }

remove_left_behind() {
  local left maker
  for left in "$1".*; do
    maker=${left#"$1".} maker=${maker%%.*}
    [[ -O $left ]] && ! kill -0 "$maker" 2> /dev/null || continue
    processes_of "$left/cluster" | xargs -r kill -KILL 2> /dev/null || true
    rm -rf "$left"
  done
}

stop_cluster() {
  [[ ${#cluster_daemons[@]} -gt 0 ]] || return 0
  scancel --user="$(id -un)" 2> /dev/null || true
  wait_for 15 queue_is_empty || true
  kill "${cluster_daemons[@]}" 2> /dev/null || true
  wait_for 15 daemons_have_ended || true
  processes_of "$cluster_folder" | xargs -r kill -KILL 2> /dev/null || true
  wait "${cluster_daemons[@]}" 2> /dev/null || true
  cluster_daemons=()
}
