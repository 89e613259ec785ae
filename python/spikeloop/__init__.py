"""Reads and draws what a run of Spikeloop leaves on disk."""
