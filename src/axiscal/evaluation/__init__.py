"""The figures of the standards, from readings alone: positioning and circles."""
