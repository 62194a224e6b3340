"""The whole job on a built-in five-axis machine whose hidden errors come from measured curves."""
