"""What the model lacks: residual, search, findings.

``blocks``   blocks of time, and the kinds of motion they are of
``library``  effects and unnamed dependences that the logs can test
``gram``     all questions about candidates, answered from Gram matrices by block
``moves``    changes of a model, screened
``score``    what a model predicts of unlike motion
``laws``     which friction law the logs support
``trace``    the search; ``finding`` what it found
``replay``   MuJoCo simulations restarted from measured states
"""
