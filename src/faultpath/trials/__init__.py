"""Arms over identical scenes."""
