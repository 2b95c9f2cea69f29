"""An identification as the service asks for it: quality gate, sweep correction, pooling of runs, design of experiments,
comparison of models. It imports `fit`, `updated_model`, `phasors` and what lies below; workers call it.
"""
