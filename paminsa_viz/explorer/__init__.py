"""The web page: state, actions, session, 3D scene, panels."""
