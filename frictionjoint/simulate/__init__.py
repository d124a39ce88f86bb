"""Friction in MuJoCo: the model carries the parameters, the data carry the state.

``carrier``  parameters in the ``<custom>`` numerics of an MJCF, exact through XML
``row``      a joint's state in ``mjData.userdata`` and the rule that commits it
``layout``   where this MuJoCo build keeps the fields the native callback touches
``callback`` the native and the Python callback
``attach``   the context manager that installs one of them
``motor``    a motor driven by voltage, which can be let go
"""
