"""The periodic orbit of beta: pieces between turning points, panels, action, conditioning."""
