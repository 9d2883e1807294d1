#!/usr/bin/env bash
# As a job array on a Slurm of one node, results are those of a single run.
set -euo pipefail
for program in munged slurmctld slurmd sbatch; do
  PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || { echo "no $program"; exit 77; }
done
source "$(dirname "$0")/cluster.sh"
export PATH=$PATH:/usr/sbin

# A cluster of its own: sockets, keys, states and ports of nobody else.
cluster=$(mktemp -d)
started=()
finish() {
  for pid in "${started[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait
  rm -rf "$cluster"
}
trap finish EXIT
dd if=/dev/urandom of="$cluster/munge.key" bs=64 count=1 status=none
chmod 700 "$cluster"
chmod 400 "$cluster/munge.key"
munged --foreground --force --key-file "$cluster/munge.key" --socket "$cluster/munge.socket" \
  --pid-file "$cluster/munged.pid" --log-file "$cluster/munged.log" --seed-file "$cluster/seed" \
  >"$cluster/munged.out" 2>&1 &
started+=($!)
port=$(python3 -c '
import socket
free = [socket.socket() for _ in range(2)]
for s in free: s.bind(("", 0))
print(*[s.getsockname()[1] for s in free])')
mkdir "$cluster/ctld" "$cluster/d"
cat >"$cluster/slurm.conf" <<EOF
ClusterName=test
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
SlurmctldPort=${port% *}
SlurmdPort=${port#* }
AuthType=auth/munge
AuthInfo=socket=$cluster/munge.socket
CredType=cred/munge
StateSaveLocation=$cluster/ctld
SlurmdSpoolDir=$cluster/d
SlurmctldPidFile=$cluster/ctld.pid
SlurmdPidFile=$cluster/d.pid
SlurmctldLogFile=$cluster/ctld.log
SlurmdLogFile=$cluster/d.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MinJobAge=300
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
export SLURM_CONF=$cluster/slurm.conf
for i in $(seq 50); do [ -S "$cluster/munge.socket" ] && break; sleep 0.1; done
slurmctld -D >/dev/null 2>&1 &
started+=($!)
slurmd -D -N "$(hostname -s)" >/dev/null 2>&1 &
started+=($!)
for i in $(seq 200); do
  state=$(sinfo --noheader --format %t 2>/dev/null || true)
  [ "$state" = idle ] && break
  sleep 0.1
done
[ "$state" = idle ] || { echo "FAILED: the node is \"$state\""; tail "$cluster"/*.log; exit 1; }

run=$SOURCE/tools/cluster/slurm.sh
"${sweep[@]}" -o whole.csv
"$run" --chunks 3 --wait -- "${sweep[@]}" -o chunks.csv
expect_equal whole.csv chunks.csv
"${bench[@]}" -o maps.csv
"$run" --chunks 2 --at-once 1 --sbatch "--time=5" --wait -- "${bench[@]}" -o maps-chunks.csv
expect_equal maps.csv maps-chunks.csv
