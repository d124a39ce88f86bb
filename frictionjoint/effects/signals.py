"""What an effect may look at: one row of numbers a sample, the same in a log and in a simulation.

TIME   s since the start of the log or simulation
Q V A  position, velocity, acceleration (rad or m)
JERK SNAP  third and fourth derivative of the position; zero in simulation
LOAD   rigid-body torque of the MJCF at this joint, N m
GEAR   the same without what turns the armature: torque the gear transmits; zero in simulation
GX GY  gravity torque of 1 kg at 1 m along the child body's two axes across the joint, N m/kg/m
TEMP   temperature, deg C; not a number in simulation, which rests at the reference
H      Fh / Fc, the hysteresis torque in units of the Coulomb level: +-1 in sliding
DTAU   time derivative of the predicted torque, N m/s; zero in simulation
DT     s since the last sample
RATE   dz/dq of the bristle, 1 at a reversal and 0 in sliding; zero in simulation
"""

TIME, Q, V, A, JERK, SNAP, LOAD, GX, GY, TEMP, H, DTAU, DT, RATE, GEAR = range(15)
N_SIGNALS = 15
