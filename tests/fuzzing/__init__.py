"""Random inputs and an oracle that knows what they say."""
