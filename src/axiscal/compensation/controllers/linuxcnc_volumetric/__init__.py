"""LinuxCNC: the whole estimate as a realtime correction between motion and drives.

One component for every machine (`axiscal_vcomp.comp`, installed once by halcompile) reads the file of a campaign when
it is loaded. The file is written by `vcomp_writing`. `vcomp_reading` and `applying` were written from its layout and
have the chain and the curves once more; a file is offered only when it does there what the estimate asks for.
"""
