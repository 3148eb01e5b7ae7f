#!/bin/bash
# sbatch --array=1-16 cluster.sh
#
# Each task of the array is one more process of the same calibration. Submit it again after a stop: finished runs are kept.
#SBATCH --job-name=seedloop
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=2G
#SBATCH --time=24:00:00
#SBATCH --requeue
#SBATCH --output=cluster-%A_%a.log
exec seedloop calibrate study.toml --resume --threads "$SLURM_CPUS_PER_TASK" --out out
