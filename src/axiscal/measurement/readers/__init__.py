"""Files of readings, poses and truths, one format each: numbers come in as SI, faults with their line."""
