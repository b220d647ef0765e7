"""Published tables beside ours; one function a paper section."""
