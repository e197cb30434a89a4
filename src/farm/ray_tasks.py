"""Shards of a dataset as Ray tasks, written by `deepshade farm plan`.

    python ray_tasks.py [SHARD...]

Makes the shards that are named, or all. The cluster is the one that RAY_ADDRESS names, else the one that runs here.
All machines see this folder and the program under the same paths. Ray places the tasks and tries them again where
they fail or their worker dies; one that always fails is named, and the others are made.
"""

import json
import os
import subprocess
import sys

import ray

JOBS = os.path.dirname(os.path.abspath(__file__))


def main():
    with open(os.path.join(JOBS, "farm.json"), encoding="utf-8") as file:
        plan = json.load(file)
    numbers = [int(word) for word in sys.argv[1:]] or range(1, plan["shards"] + 1)

    @ray.remote(num_cpus=plan["cores"], max_retries=plan["retries"], retry_exceptions=True)
    def shard(number):
        command = [plan["program"], "farm", "work", JOBS, "--shard", str(number)]
        environment = {**os.environ, "RAYON_NUM_THREADS": str(plan["cores"])}
        with open(os.path.join(JOBS, "logs", f"{number}.log"), "ab") as log:
            subprocess.run(
                command, check=True, env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                timeout=60 * plan["minutes"],
            )

    ray.init(address=os.environ.get("RAY_ADDRESS", "auto"))
    waiting = {shard.remote(number): number for number in numbers}
    failed = []
    while waiting:
        (done, *_), _ = ray.wait(list(waiting))
        number = waiting.pop(done)
        try:
            ray.get(done)
            print(f"shard {number}: made", flush=True)
        except Exception as error:  # Whatever it is, the others go on.
            failed.append(number)
            print(f"shard {number}: failed: {type(error).__name__}", flush=True)
    if failed:
        sys.exit(f"failed: {' '.join(map(str, sorted(failed)))}; `deepshade farm status` says why")


main()
