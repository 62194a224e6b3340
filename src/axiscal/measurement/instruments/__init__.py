"""The kinds of instruments, one file each; they do not know each other, the table of `instrument` knows them all."""
