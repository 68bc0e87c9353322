#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Run by ctest as scripts.slurm (scripts/test nightly); for whoever changes scripts/slurm or how processes share a run.
# scripts/slurm/submit against a real Slurm, on this machine: starts a cluster of one node on loopback in a temporary folder,
# disturbs each of 4 tasks in the middle of its work in a way of its own, and compares the tables with those of one process.
# Prints each check; nothing is left behind. Skipped (status 77) on a machine without Slurm.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
for needed in munged slurmctld slurmd sbatch pgrep; do
  command -v "$needed" > /dev/null || { echo "skipped: $needed is not installed (scripts/setup slurm)"; exit 77; }
done
program=$SALBENCH_PROGRAM submit=$PWD/scripts/slurm/submit toy_meshes=$PWD/scripts/toy_meshes.py
. scripts/common.sh

# -- a Slurm cluster of one node on this machine's loopback. It lives in an empty folder of its own, with its own ports, munge key and
# socket: a Slurm or munge that the machine runs already is neither used nor touched, and the user need not be root. No folder above it may be
# closed to others (munge insists). SLURM_CONF leads every Slurm command to it.

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

# -- the test

failed=0
patience=1500  # seconds, for what has to come and stays; a test that fails ends in order before ctest kills it
# check WHAT COMMAND...: passes where the command succeeds.
check() {
  if "${@:2}"; then echo "ok      $1"; else echo "FAILED  $1"; failed=$((failed + 1)); fi
}
give_up() { echo "FAILED  $*"; exit 1; }

finish() {
  local status=$?
  [[ $status -eq 0 ]] || tail -n 15 "$folder"/cluster/*.log "$work"/out*/slurm/*.log || true
  stop_cluster
  jobs -p | xargs -r kill 2> /dev/null || true
  wait
  rm -rf "$folder"
  [[ $status -eq 0 ]] && echo "passed in $SECONDS s" || echo "FAILED after $SECONDS s"
}

# Blanks and a % in the names, and a current folder that is not the repository.
remove_left_behind /tmp/salbench-slurm
folder=$(mktemp -d "/tmp/salbench-slurm.$$.XXXXXX")
work="$folder/100% toys"
trap finish EXIT
trap 'exit 1' HUP INT TERM
mkdir "$folder/cluster" "$work"
chmod 755 "$folder"
cd "$work"
config="toy set.yaml"
cat > "$config" << END
dataset: {layout: folder, participants: simulated}
scan: {step_degrees: 1}
models: {LS: , HS: , RS: , MINE: {command: "sh '$work/model.sh' {mesh} {out}"}}
END
"$toy_meshes" "data set" 8 24 12
# Where each share is held in the middle of its work, as long as there is a file `hold`. It counts the points.
cat > model.sh << END
[ -z "\$SLURM_ARRAY_TASK_ID" ] || touch '$work/held by '\$SLURM_ARRAY_TASK_ID
while [ -e '$work/hold' ]; do sleep 0.1; done
seq "\$(grep -a -m 1 'element vertex' "\$1" | cut -d' ' -f3)" > "\$2"
END

# What Slurm says of a job, and what the program says of a share.
field() { scontrol show job --oneliner "$1" | sed "s/.* $2=\([^ ]*\).*/\1/"; }
state_of() { field "$1" JobState; }
restarts_of() { field "$1" Restarts; }
has_ended() { [[ ! $(state_of "$1") =~ ^(|PENDING|RUNNING|COMPLETING|REQUEUED.*)$ ]]; }
jobs_left() {
  "$program" plan "$config" --data "data set" --cache "$cache" --shard "$1" --format json |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["open"])'
}
number() { sed -n "s/^$1: //p" "$2"; }

# submit_to N OPTION...: sets array and merge to the ids of the two jobs.
submit_to() {
  local said
  said=$("$submit" "$config" --tasks "$@" -- --data "data set" --out "$out" --cache "$cache" --threads 1 --quiet --keep-going)  # or the model comes first
  array=$(sed -n 's/^job \([0-9]*\):.*/\1/p' <<< "$said") merge=$(sed -n 's/.*; job \([0-9]*\) then.*/\1/p' <<< "$said")
}

# The process that computes a share; its parent is the batch script.
program_of() { pgrep -o -f "python3 -PXutf8 $program run .*$folder.* --cache $cache .* --shard $1\$"; }

is_gone() { ! kill -0 "$1"; }

echo "-- one process"
cache=cache1
jobs=$(jobs_left 1/4)
"$program" run "$config" --data "data set" --cache cache1 --out out1 --quiet &
wait $!  # rather than in the foreground, where a signal would be heard at its end only

start_cluster "$folder/cluster" 4 || give_up "Slurm did not start"
echo "-- 4 tasks on $(scontrol --version), each disturbed in the middle"
cache=cache4 out=out4
touch hold
submit_to 4
declare -A left
for i in 1 2 3 4; do wait_for "$patience" test -e "held by $i" || give_up "share $i did not come to its model"; done
for i in 1 2 3 4; do
  victim=$(program_of $i/4)
  case $i in
    1) scontrol requeue "${array}_1" ;;                        # as a preemption does
    2) kill -KILL "$victim" ;;                                 # as a node short of memory does
    3) scancel --batch --signal=TERM "${array}_3" ;;           # as the end of the time allowed draws near
    4) kill -KILL "$(ps -o ppid= "$victim" | tr -d ' ')" "$victim" ;;  # nobody is left who could requeue it
  esac
  wait_for "$patience" is_gone "$victim" || give_up "the program of share $i did not end"
  left[$i]=$(jobs_left $i/4)
  # What was computed of a mesh in the last seconds is lost to SIGKILL, and kept where the program ends in order.
  at_most=$((i % 2 == 0 ? jobs : jobs - 1))
  check "share $i was ended with ${left[$i]} of $jobs artefacts to compute" test "${left[$i]}" -gt 0 -a "${left[$i]}" -le "$at_most"
done
rm hold
wait_for "$patience" has_ended "$merge" || give_up "the merging job did not end"

says=([1]='left to Slurm' [2]='exit status 137' [3]='exit status 130')
for i in 1 2 3; do
  check "share $i, by its log: ${says[$i]}" grep -q "$i/4: .*${says[$i]}" "$out/slurm/${array}_$i.log"
  check "share $i was restarted once and completed" test "$(restarts_of "${array}_$i") $(state_of "${array}_$i")" = "1 COMPLETED"
  computed=$(number artefacts_computed "$out/shard_${i}_of_4.yaml")
  check "share $i went on from the cache: $computed artefacts" test "$computed" -gt 0 -a "$computed" -le "${left[$i]}"
done
check "share 4 ended for good" test "$(restarts_of "${array}_4") $(state_of "${array}_4")" = "0 FAILED"
check "the merging job names it: $(grep -m 1 'not complete' "$out/slurm/merge_$merge.log" | cut -d' ' -f2-)" \
  grep -q "left to this job: 4/4 (${left[4]} jobs left)$" "$out/slurm/merge_$merge.log"
check "the merging job completed" test "$(state_of "$merge")" = COMPLETED
contents() { contents_of_cache "$(dirname "$program")/python" "$1"; }
check "the cache holds the $(contents cache1 | wc -l) contents of that of one process" cmp -s <(contents cache1) <(contents cache4)
for table in out1/*.csv; do
  name=$(basename "$table")
  [[ $name != costs.csv ]] || continue  # how long maps took
  check "$name is that of one process: $(wc -c < "$table") bytes" cmp -s "$table" "out4/$name"
done

echo "-- given up after as many restarts as allowed, and cancelled"
cache=cache2 out=out2
jobs=$(jobs_left 1/2)
rm "held by "*
touch hold
submit_to 2 --restarts 0
for i in 1 2; do wait_for "$patience" test -e "held by $i" || give_up "share $i did not come to its model"; done
kill -KILL "$(program_of 1/2)"
wait_for "$patience" has_ended "${array}_1" || give_up "share 1 did not end"
check "share 1, not to be restarted, failed when its program was killed" \
  test "$(restarts_of "${array}_1") $(state_of "${array}_1")" = "0 FAILED"
scancel "$array" "$merge"
wait_for "$patience" queue_is_empty || give_up "what was cancelled did not end"
check "share 2 and the merging job were cancelled" \
  test "$(state_of "${array}_2") $(restarts_of "${array}_2") $(state_of "$merge")" = "CANCELLED 0 CANCELLED"
check "share 2, by its log: left to Slurm" grep -q "left to Slurm" "$out/slurm/${array}_2.log"
check "no table was written" test ! -e "$out/results.csv"

exit $((failed > 0))
