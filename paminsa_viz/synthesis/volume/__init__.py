"""Where all requirements of a robot hold, which of them do, and which contradict."""
