"""A dial that answers every question by a fixed curve, and cannot reach one end of the way."""

import json
import sys

for line in sys.stdin:
    x = json.loads(line)["position"]["X"]
    answer = (
        {"skip": "the stand is in the way"} if x > 9.9 else {"value": 300 * x - 40 * x * x, "unit": "um", "std": 80}
    )
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()
