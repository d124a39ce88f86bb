"""Arms simulated by MuJoCo alone, with what their models do not know: trial data of whole robots.

Only `fitted` imports the project. Joint friction is a LuGre law stepped beside `mj_step`; the arm
follows sums of sines under feed-forward of the believed model and a PD controller; encoders count,
torques carry noise.

arm      random serial arms, and what can be hidden in them
run      an arm under control: its logs
fitted   its joints, each with its first fit
"""
