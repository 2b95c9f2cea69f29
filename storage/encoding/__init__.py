"""Sample blocks and text as they are stored. Repositories encode and decode with it; it imports no other room, only the
estimator's data types."""
