"""Stacked axes.

The paper's sample machine: three axes on top of each other, one dial that reads the sum of their height errors. Only
the sum of the three constants can ever be seen. The paper's measure J counts the other two combinations for ever; the
height itself is known well.
"""

from axiscal.ports.paper.stack import greedy, three_joints


def main() -> dict[str, object]:
    """Return what 19 readings do to J and to the height."""
    stack = three_joints()
    plan = greedy(stack, 22)
    height = [variance**0.5 for variance in plan.height_variances]
    single = [(variance / stack.length) ** 0.5 for variance in plan.overall_variances]
    readings = list(range(len(height)))
    return {
        "J before": plan.overall_variances[0],
        "J after the first reading": plan.overall_variances[1],
        "J that no reading takes away": stack.variance_left,
        "height known to, before": height[0],
        "picture": {
            "x": "readings",
            "y": "standard deviation, RMS",
            "log": True,
            "lines": {"one joint": (readings, single), "the height": (readings, height)},
        },
    }


if __name__ == "__main__":
    print({name: value for name, value in main().items() if name != "picture"})
