"""LinuxCNC: the whole estimate as a realtime correction between motion and drives.

One component for every machine (`axiscal_vcomp.comp`, installed once by halcompile) reads the file of a campaign when
it is loaded. `tables.vcomp` writes that file, follows its layout, and has the chain and the curves once more: a file is
offered only if it does there what the estimate asks for.
"""
