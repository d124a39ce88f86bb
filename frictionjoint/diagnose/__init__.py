"""Identify one joint and search for what its model lacks.

``close_loop``       from logs to a report, step by step
``joint_logs``       the logs as recorded and as prepared, fitted and held out
``trace``            the search; ``finding`` its outcome
``library``          effects and unnamed dependences that the logs can test
``gram``             scores of candidates from Gram matrices by block
``moves``            changes of a model, screened; ``score`` their cross-validated score
``other_laws``       friction laws that the logs support
``resulting_model``  the model after refinement by simulation
``build_report``     the report; ``report_parts`` its figures
``proposal``         what to record next; ``motions`` the motions that are tried
"""
