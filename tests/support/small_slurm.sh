#!/usr/bin/env bash
# A Slurm of one node on this machine, for tests: munged, slurmctld and slurmd with files, ports and a key of their own.
#   small_slurm.sh start FOLDER    starts it; FOLDER/slurm.conf is what SLURM_CONF has to name
#   small_slurm.sh stop FOLDER     ends it, by the process ids that it left
# Exit 77 where it cannot be: no Debian packages slurmctld, slurmd, slurm-client and munge, or not root.
set -euo pipefail
[[ $# -eq 2 ]] || { sed -n '2,5s/^# //p' "$0" >&2; exit 2; }
mkdir -p "$2"
folder=$(realpath "$2")

stop() {
  for name in slurmd slurmctld munged; do
    pid=$(cat "$folder/$name.pid" 2>/dev/null) || continue
    kill "$pid" 2>/dev/null || true
    for _ in $(seq 100); do kill -0 "$pid" 2>/dev/null || break; sleep 0.1; done
    kill -9 "$pid" 2>/dev/null || true
  done
}
if [[ $1 == stop ]]; then stop; exit 0; fi

for tool in munged slurmctld slurmd sbatch squeue scontrol; do
  command -v "$tool" >/dev/null || { echo "SKIPPED: there is no $tool; install slurmctld slurmd slurm-client munge"; exit 77; }
done
[[ $(id -u) -eq 0 ]] || { echo "SKIPPED: slurmd has to be started by root"; exit 77; }

host=$(hostname -s)
mkdir -p "$folder/state" "$folder/spool" "$folder/munge"
chmod 755 "$folder"; chmod 700 "$folder/munge"
head -c 1024 /dev/urandom >"$folder/munge/key"; chmod 600 "$folder/munge/key"
# Ports that are free now.
read -r port1 port2 < <(python3 -c 'import socket
s = [socket.socket() for _ in range(2)]
for x in s: x.bind(("127.0.0.1", 0))
print(*[x.getsockname()[1] for x in s])')
cat >"$folder/slurm.conf" <<CONF
ClusterName=small
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/munge/socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=1
SlurmctldPort=$port1
SlurmdPort=$port2
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmdSpoolDir=$folder/spool
StateSaveLocation=$folder/state
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=batch_sched_delay=0,sched_interval=5
KillWait=5
MinJobAge=300
JobAcctGatherType=jobacct_gather/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$(awk '/MemTotal/ {print int($2 / 1024 * 0.8)}' /proc/meminfo) State=UNKNOWN
PartitionName=debug Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$folder/slurm.conf
munged --force --socket="$folder/munge/socket" --key-file="$folder/munge/key" --pid-file="$folder/munged.pid" --seed-file="$folder/munge/seed" --log-file="$folder/munge/log"
slurmctld -f "$SLURM_CONF"
slurmd -f "$SLURM_CONF"
for _ in $(seq 150); do
  if sinfo -h -o %t 2>/dev/null | grep -q idle; then exit 0; fi
  sleep 0.2
done
echo "small_slurm.sh: error: the node is not idle after 30 s; see $folder/*.log" >&2
stop
exit 1
