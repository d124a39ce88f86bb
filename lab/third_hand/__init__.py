"""Trial plants of a third hand: logs of joints that hide effects, with the answer beside them.

Written from the textbook forms of the effects alone. Nothing here imports the project, and the
project's friction law, effects and search were not consulted, so that a search that does well on
these plants does not owe it to a shared formula or a shared mistake.

    python -m lab.third_hand OUT --n 40 --seed 7
    python -m lab.third_hand OUT --n 6 --seed 7 --kinds none joint-elasticity spring+backlash

writes OUT/<number>/{fit1,fit2,fit3,held}.csv, model.xml (what the user believes about the joint)
and answer.json (what it is in truth). A plant depends on the seed and its number only.

joint      what a joint is: inertia, gravity, friction, and everything it may hide
friction   four friction laws with presliding
control    four position controllers
integrate  the joint under control, fourth-order Runge-Kutta
motion     five styles of reference motion
hidden     sizes of the hidden effects, drawn at random, and what may be combined
instrument encoder, sampling and torque noise
effect     how much torque each effect moves, and which other names would explain the same
plant      one plant drawn, simulated and judged usable
files      the plant written to a folder
"""
