"""Machines, set-ups, readings and campaigns that the tests of many rooms are tried on."""
