#!/bin/bash
# Checks a folder of parts as a Slurm array: one shard a task, into one folder that all tasks see.
#
#   sbatch --array=0-15 config/batch/slurm.sh PARTS OUT --process sla
#   sculptd check --merge --out OUT        # when all tasks have ended
#
# A task that was stopped goes on where it was: submit it again.
#SBATCH --job-name=sculptd-check
#SBATCH --cpus-per-task=4
#SBATCH --mem=4G
#SBATCH --requeue
set -euo pipefail
parts=$1 out=$2
shift 2
count=${SLURM_ARRAY_TASK_COUNT:?run this as an array: sbatch --array=0-15}
shard=$((SLURM_ARRAY_TASK_ID - ${SLURM_ARRAY_TASK_MIN:-0} + 1))
code=0
"${SCULPTD:-sculptd}" check "$parts" --out "$out" --shard "$shard/$count" \
    --jobs "${SLURM_CPUS_PER_TASK:-1}" "$@" >"$out.$shard.log" || code=$?
# 1: some parts are not ready, which the table says. The task has done its work.
if [ "$code" -ne 0 ] && [ "$code" -ne 1 ]; then
    exit "$code"
fi
