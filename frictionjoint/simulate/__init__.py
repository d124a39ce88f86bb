"""Friction in MuJoCo: the model contains the parameters, the data contain the state.

``carrier``  parameters in the ``<custom>`` numerics of an MJCF, exact through XML
``row``      a joint's state in ``mjData.userdata`` and the rule that commits it
``layout``   offsets of the fields that the native callback uses, in this MuJoCo build
``callback`` the native and the Python callback
``attach``   the context manager that installs one of them
``motor``    a motor driven by voltage, which can be switched off
"""
