"""What the model lacks: residual, trace, the loop.

``blocks``      sums of squares and products by block of time, on which all statistics run
``candidates``  effects and smooth curves to try, with the search for periods in position
``trace``       ranking of the candidates: held-out gain, false-alarm control, ties
``loop``        base fit, trace, add, refit, until nothing more is justified
``replay``      MuJoCo simulations restarted from measured states
"""
