#!/bin/bash
#SBATCH --job-name=faultpath
#SBATCH --nodes=16
#SBATCH --ntasks-per-node=1
#SBATCH --cpus-per-task=64
#SBATCH --exclusive
#SBATCH --time=08:00:00

source /shared/study/.venv/bin/activate   # on the file system that all nodes share
cd /shared/study

head=$(scontrol show hostnames "$SLURM_JOB_NODELIST" | head -n 1)
ip=$(srun --nodes=1 --ntasks=1 -w "$head" hostname --ip-address | awk '{print $1}')

srun --nodes="$SLURM_JOB_NUM_NODES" --ntasks="$SLURM_JOB_NUM_NODES" \
  --cpus-per-task="$SLURM_CPUS_PER_TASK" \
  ray symmetric-run --address "$ip:6379" --min-nodes "$SLURM_JOB_NUM_NODES" \
    --num-cpus="$SLURM_CPUS_PER_TASK" -- \
  faultpath audit my_system.py --baseline plain --repair mended --fault mass:scale=1.1 \
    --library all --seeds 0,1,2,3,4 --executor "ray:$ip:6379" --out runs/million
