"""Controls of printers: the files they load, and readings and tables over the network."""
