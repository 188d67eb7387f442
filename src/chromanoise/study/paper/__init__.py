"""The paper's own study: its tables as printed and as computed, its planes, what they say."""
