//! The address space: the specifications from their node sets, and the machine. Clients read, and may propose orders;
//! nothing can be written.

use std::sync::Arc;

use opcua::nodes::{DefaultTypeTree, NodeSet2Import, TypeTree};
use opcua::server::address_space::AddressSpace;
use opcua::server::diagnostics::NamespaceMetadata;
use opcua::server::node_manager::memory::{
    InMemoryNodeManager, InMemoryNodeManagerImpl, InMemoryNodeManagerImplBuilder,
};
use opcua::server::node_manager::{MethodCall, NodeManager, RequestContext, ServerContext};
use opcua::sync::RwLock;
use opcua::types::{NodeClass, NodeId, ObjectTypeId, QualifiedName, StatusCode, Variant};

use super::accounts;
use super::adapter_state::AdapterState;
use super::log::log_line;
use super::machine_tool::{self, MachineNodes};
use super::node_builder::{Namespace, NamespaceIndices};
use super::order_desk::{self, OrderDesk, ProposalAnswer};

/// The manager of the machine's nodes.
pub type MachineNodeManager = InMemoryNodeManager<MachineAddressSpace>;

/// The specifications, each after those that it needs. They are read from their files as published by the OPC Foundation.
const NODE_SETS: [&str; 6] = [
    include_str!("../../../assets/opcua/Opc.Ua.Di.NodeSet2.xml"),
    include_str!("../../../assets/opcua/Opc.Ua.IA.NodeSet2.xml"),
    include_str!("../../../assets/opcua/Opc.Ua.Machinery.NodeSet2.xml"),
    include_str!("../../../assets/opcua/opc.ua.isa95-jobcontrol.nodeset2.xml"),
    include_str!("../../../assets/opcua/Opc.Ua.Machinery.Jobs.Nodeset2.xml"),
    include_str!("../../../assets/opcua/Opc.Ua.MachineTool.NodeSet2.xml"),
];

/// Longest order in the log, characters.
const LONGEST_LOG: usize = 300;

/// Builds the address space for a machine.
pub struct MachineBuilder {
    /// What the control has told.
    pub state: AdapterState,
    /// Where orders are handed in.
    pub desk: OrderDesk,
}

impl InMemoryNodeManagerImplBuilder for MachineBuilder {
    type Impl = MachineAddressSpace;

    fn build(self, context: ServerContext, space: &mut AddressSpace) -> MachineAddressSpace {
        let mut fault = None;
        let indices = {
            let mut types = context.type_tree.write();
            for text in NODE_SETS {
                match NodeSet2Import::new_str("en", text, Vec::new()) {
                    Ok(set) => space.import_node_set(&set, types.namespaces_mut()),
                    Err(error) => fault = Some(format!("node set: {error}")),
                }
            }
            NamespaceIndices(Namespace::ALL.map(|namespace| types.namespaces_mut().add_namespace(namespace.uri())))
        };
        space.add_namespace(Namespace::Own.uri(), indices.of(Namespace::Own));
        let of_namespace = |(index, uri): (&u16, &String)| NamespaceMetadata {
            namespace_uri: uri.clone(),
            namespace_index: *index,
            is_namespace_subset: Some(false),
            ..Default::default()
        };
        let nodes = Arc::new(machine_tool::create(space, indices, &self.state));
        let namespaces = space.namespaces().iter().map(of_namespace).collect();
        MachineAddressSpace { nodes, namespaces, fault, desk: self.desk }
    }
}

/// The machine's part of the address space.
pub struct MachineAddressSpace {
    /// The machine.
    pub nodes: Arc<MachineNodes>,
    /// What is wrong with a node set.
    pub fault: Option<String>,
    namespaces: Vec<NamespaceMetadata>,
    desk: OrderDesk,
}

#[async_trait::async_trait]
impl InMemoryNodeManagerImpl for MachineAddressSpace {
    async fn init(&self, _: &mut AddressSpace, _: ServerContext) {}

    fn name(&self) -> &str {
        "machine"
    }

    fn namespaces(&self) -> Vec<NamespaceMetadata> {
        self.namespaces.clone()
    }

    async fn call(
        &self,
        context: &RequestContext,
        _: &RwLock<AddressSpace>,
        calls: &mut [&mut &mut MethodCall],
    ) -> Result<(), StatusCode> {
        for call in calls.iter_mut().filter(|call| *call.method_id() == self.nodes.plan.method) {
            match self.propose(context, call.arguments()).await {
                Ok(answer) => {
                    let reason = answer.why.unwrap_or_default();
                    call.set_outputs(vec![Variant::Boolean(answer.proposed), Variant::from(reason)]);
                    call.set_status(StatusCode::Good);
                }
                Err(status) => call.set_status(status),
            }
        }
        Ok(())
    }
}

impl MachineAddressSpace {
    /// Hands an order in for a user, and logs what became of it.
    async fn propose(&self, context: &RequestContext, arguments: &[Variant]) -> Result<ProposalAnswer, StatusCode> {
        let text = order_desk::order_text(arguments)?;
        let answered = self.desk.propose(text.clone()).await;
        let user = accounts::name_of(&context.token);
        // A long one is refused: the log does not need all of it.
        let text: String = text.chars().take(LONGEST_LOG).collect();
        match &answered {
            Ok(ProposalAnswer { why: None, .. }) => log_line(&format!("{user} proposes {text}")),
            Ok(ProposalAnswer { why: Some(why), .. }) => log_line(&format!("{user} proposes {text}: refused: {why}")),
            Err(status) => log_line(&format!("{user} proposes {text}: {status}")),
        }
        answered
    }
}

/// Makes the fields that alarms inherit selectable by their own type: the library looks them up in the exact type alone. It
/// owns no node.
pub struct EventFields;

#[async_trait::async_trait]
impl NodeManager for EventFields {
    fn owns_node(&self, _: &NodeId) -> bool {
        false
    }

    fn name(&self) -> &str {
        "event fields"
    }

    fn namespaces_for_user(&self, _: &RequestContext) -> Vec<NamespaceMetadata> {
        Vec::new()
    }

    async fn init(&self, types: &mut DefaultTypeTree, _: ServerContext) {
        let condition = NodeId::from(ObjectTypeId::ConditionType);
        // ConditionId: the node of the event itself.
        types.add_type_property(&condition, &condition, &[], NodeClass::Object);
        let own = types.namespaces().get_index(Namespace::Own.uri());
        let machine_tool = types.namespaces().get_index(Namespace::MachineTool.uri());
        let (Some(own), Some(machine_tool)) = (own, machine_tool) else { return };
        let fields: &[&[&str]] = &[
            &["EventId"],
            &["EventType"],
            &["SourceNode"],
            &["SourceName"],
            &["Time"],
            &["ReceiveTime"],
            &["Message"],
            &["Severity"],
            &["ConditionClassId"],
            &["ConditionClassName"],
            &["ConditionName"],
            &["BranchId"],
            &["Retain"],
            &["EnabledState"],
            &["EnabledState", "Id"],
            &["Quality"],
            &["LastSeverity"],
            &["Comment"],
            &["ClientUserId"],
            &["AckedState"],
            &["AckedState", "Id"],
            &["ActiveState"],
            &["ActiveState", "Id"],
            &["InputNode"],
            &["SuppressedOrShelved"],
        ];
        let message = NodeId::new(own, machine_tool::MESSAGE_EVENT_TYPE);
        for kind in [NodeId::new(machine_tool, machine_tool::ALERT_NUMBER), message] {
            for field in fields {
                let path: Vec<QualifiedName> = field.iter().map(|name| QualifiedName::new(0, *name)).collect();
                inherit(types, &kind, &path);
            }
        }
        let identifier = [QualifiedName::new(machine_tool, "Identifier")];
        inherit(types, &NodeId::new(own, machine_tool::MESSAGE_EVENT_TYPE), &identifier);
    }
}

/// Enters a field of a supertype for a type of events.
fn inherit(types: &mut DefaultTypeTree, kind: &NodeId, path: &[QualifiedName]) {
    let mut at = kind.clone();
    while let Some(above) = types.get_supertype(&at).cloned() {
        if let Some(found) = types.find_type_prop_by_browse_path(&above, path).cloned() {
            let path: Vec<&QualifiedName> = path.iter().collect();
            types.add_type_property(&found.node_id, kind, &path, found.node_class);
            return;
        }
        at = above;
    }
}
