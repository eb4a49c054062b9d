#!/usr/bin/env bash
# Runs short simulated dives by a real Slurm on this machine and takes workers away in between. Checks that each run has
# one result and none was made twice. A long experiment, for root (make fleet-test):
#   LODELINE=build/release/bin/lodeline test_slurm.sh [ITEMS [DIVES [KILLS]]]
# It needs Debian's slurm-wlm and munge, and leaves other daemons of both alone. WORK names its folder.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
. "$here/test_common.sh"
items=${1:-200}
dives=${2:-$items}
kills=${3:-20}
tasks=8
prepare_fleet slurm "$items" "$dives"
slurm=$work/slurm
mkdir -p "$slurm"/{state,spool,munge}
chmod 700 "$slurm/munge"
(umask 277 && head -c 1024 /dev/urandom > "$slurm/munge/key")
port=$((20000 + RANDOM % 20000))
cat > "$slurm/slurm.conf" <<EOF
ClusterName=fleet
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=root
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$slurm/munge/socket
CredType=cred/munge
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SlurmdParameters=config_overrides
ReturnToService=2
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$tasks RealMemory=64000 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
export SLURM_CONF=$slurm/slurm.conf

daemons=()
start() {
  "$@" > "$slurm/$1.log" 2>&1 &
  daemons+=($!)
  sleep 1
}
stop() {
  scancel --quiet --partition=all 2>/dev/null || true
  sleep 2
  [ ${#daemons[@]} -eq 0 ] || kill "${daemons[@]}" 2>/dev/null || true
}
trap stop EXIT
start munged --foreground --force --key-file="$slurm/munge/key" --socket="$slurm/munge/socket" \
  --pid-file="$slurm/munge/pid" --log-file="$slurm/munge/log" --seed-file="$slurm/munge/seed"
start slurmctld -D -c
start slurmd -D -c
is_up() { sinfo -h -o %T 2>/dev/null | grep -Eq 'idle|mixed|allocated'; }
for _ in $(seq 60); do is_up && break || sleep 1; done
is_up || { tail -n 5 "$slurm"/*.log >&2; echo "slurmd did not come up" >&2; exit 1; }

# Whether tasks run or will soon; Slurm lets requeued ones wait two minutes (BeginTime).
is_running() { squeue -h -o %r 2>/dev/null | grep -qv BeginTime; }
# The array of the example; the same line goes on from where another array stopped.
submit() {
  LODELINE=$lodeline sbatch --quiet --requeue --array="1-$tasks" --cpus-per-task=1 --mem=1G \
    --output="$slurm/%A_%a.out" "$here/batch.sbatch" "$work/list.yaml" "$work/out"
}
submit
for kill in $(seq "$kills"); do
  while [ "$(results)" -lt $((items * kill / (kills + 1))) ] || [ -z "$(workers)" ]; do
    is_running || submit
    sleep 0.2
  done
  # Half of the workers die; Slurm puts the others back into its queue.
  if [ $((kill % 2)) -eq 0 ]; then
    kill_worker || true
  else
    task=$(squeue -h -t R -o %i | shuf -n 1)
    [ -z "$task" ] || { scontrol requeue "$task" && echo "requeued task $task at $(results) results"; } || true
  fi
done
while [ "$(results)" -lt "$items" ]; do
  is_running || submit
  sleep 0.5
done
while is_running; do sleep 0.5; done
check_fleet "$items"
