BEGIN OLD_AXIS .COM MM
NR        AXISPOS    BACKLASH           X           Y           Z
0       -100.0000      0.0000      0.0000      0.0000      0.0000
1          0.0000      0.0000      0.0000      0.0000      0.0000
[END]
