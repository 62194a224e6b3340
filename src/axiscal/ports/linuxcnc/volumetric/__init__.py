"""LinuxCNC: the whole estimate as a realtime correction between motion and drives.

One component for every machine (`axiscal_vcomp.comp`, installed once by halcompile) reads the file of a campaign when
it is loaded. `vcomp_writing` writes the file. `vcomp_reading` and `applying` follow its layout and have the chain and
the curves once more. A file is offered only if it does there what the estimate asks for.
"""
