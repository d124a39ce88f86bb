"""Search for what the model lacks.

``library``  effects and unnamed dependences that the logs can test
``gram``     scores of candidates from Gram matrices by block
``moves``    changes of a model, screened
``score``    cross-validated score
``laws``     friction laws that the logs support
``trace``    the search; ``finding`` its outcome
"""
