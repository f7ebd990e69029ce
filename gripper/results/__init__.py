"""What an answer says: poses, peaks, summary, as plain data and as text."""
