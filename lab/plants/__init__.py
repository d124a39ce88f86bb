"""Trial plants: single joints built from MuJoCo's own parts, for logs whose truth is known.

Nothing here imports the friction law or the effects of the package under test. The rigid body,
springs, gaps, stops, cogging and the second joint are MuJoCo's; the friction is one of several
other laws (generalised Maxwell-slip, LuGre, elasto-plastic, or MuJoCo's own `frictionloss` with a
Stribeck level), integrated in the stepping loop at 0.1 ms and applied as a torque.
"""
