"""The plugins that come with gripper: objects, fingers, jaws. One plugin a file."""
