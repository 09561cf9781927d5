"""`camring studio`: a page in the browser on which a motor is designed by hand.

A server on this machine alone keeps the motor file that is open and answers each movement of
the hand with the numbers of every picture. Nothing else in the package imports it but its
command. docs/guide/studio.md is its guide, docs/notes/studio.md says how it is made.
"""
