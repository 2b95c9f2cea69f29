"""The science of Rundown: pure functions on arrays. No input or output, no clock, no other package of the project."""
