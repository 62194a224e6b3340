"""axiscal plans, runs and evaluates the calibration of machine tools, and says how good the machine then is."""

__version__ = "0.1.0"
